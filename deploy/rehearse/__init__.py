"""The image built for real, and docker-compose.yml run without an engine: each service in namespaces of its own."""
