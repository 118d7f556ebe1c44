"""Compiled kinematics: where links, tcp and collision spheres are, and which joints put the tcp where."""
