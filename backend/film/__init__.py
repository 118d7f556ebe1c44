"""Films of trials: drawn without a screen or a graphics card, written as GIF or MP4."""
