"""What the site draws from the project itself: reference of the effects, command line, pictures."""
