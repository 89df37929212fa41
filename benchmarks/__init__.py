"""What is measured again and again: runs that take too long for the tests."""
