"""Pictures of bodies, drawn without a display."""
