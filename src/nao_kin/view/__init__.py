"""Robots as pictures: a scene of triangles and poses as plain data, and one self-contained HTML page of it."""
