"""One module per source document, assembling the library as that document does."""
