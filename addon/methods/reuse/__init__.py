"""What reprojected reflections share: buffers of earlier pictures, how they are shifted, warped and gathered."""
