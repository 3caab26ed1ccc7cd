"""What images of objects on curved mirrors are made of: reflectors' bundles of rays, searches, grids, meshes."""
