"""The API of a real service: a package, so that the service that its tests share ends with its last test."""
