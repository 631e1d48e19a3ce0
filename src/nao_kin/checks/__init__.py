"""The consistency check of URDF files: rules on the text, rules on the model, and how findings are printed."""
