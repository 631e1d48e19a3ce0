"""S. Bischoff's bachelor thesis on inverse upper-body kinematics of the NAO, April 2016: a module a section."""
