"""Everything with a screen or a socket."""
