"""What strangers do: slow and odd connections, odd requests, odd texts; and processes that are killed and stopped."""
