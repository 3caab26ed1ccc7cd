"""One file per real-time method, and the contract they keep."""
