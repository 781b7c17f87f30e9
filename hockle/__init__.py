"""The front door: the command line, and the supervisor that starts broker, API and workers together."""
