"""What a run leaves, as frozen values: written, read and described by one mechanism (`values`, `files`)."""
