"""What crfnet costs and withstands, measured: `make bench`."""
