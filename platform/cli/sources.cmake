target_sources(pliant_host PRIVATE)
