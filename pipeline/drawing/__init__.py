"""What figures and pictures have in common: plots with plotly, and pictures of bodies without a display."""
