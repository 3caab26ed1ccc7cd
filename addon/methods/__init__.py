"""One file per real-time method, the contract they keep, and a folder of parts for each family that needs many."""
