"""The page: 3-D layers, panels, and the dashboard that draws them."""
