"""What glossy floors share: the lobe, attenuation planes, distances behind a plane."""
