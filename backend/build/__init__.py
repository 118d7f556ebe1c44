"""How each piece of knowledge is made: offline, repeatable by seed, one command each."""
