"""Services under harm: a package, so that the services that its tests share end with its last test."""
