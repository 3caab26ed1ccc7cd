"""The level designer's preview: a window to fly through a scene in, and films of such flights."""
