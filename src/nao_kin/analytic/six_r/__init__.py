"""Arms of five and six turning joints: recognised by their axes, solved by the form that fits."""
