"""The command line: from scene files to compared pictures, without a window."""
