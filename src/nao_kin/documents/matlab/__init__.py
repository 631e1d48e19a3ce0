"""The MathWorks example on the closed-form inverse kinematics of a NAO head."""
