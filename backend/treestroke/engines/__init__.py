"""Programs and libraries of others that work on files, each behind one function."""
