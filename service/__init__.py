"""hockle as a service: cases, jobs, results, and the HTTP interface."""
