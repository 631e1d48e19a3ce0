"""The chains of the source documents, as printed: one module a document, and the list of them all."""
