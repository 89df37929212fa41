"""What crfnet costs and withstands, measured again and again: runs that take too long for the tests."""
