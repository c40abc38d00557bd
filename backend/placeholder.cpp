namespace motorcade {}
