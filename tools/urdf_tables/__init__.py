"""The robots of `urdf/` as data tables, and the small modules that turn a table into a URDF file.

Every figure names its public source. Lengths are metres, angles radians, masses kilograms unless a name says
otherwise.
"""
