"""Executes a notebook in the current folder, and writes it with its outputs: the same file for the same outputs.

    python execute.py NOTEBOOK OUTPUT
"""

import sys

import nbformat
from nbclient import NotebookClient

source, output = sys.argv[1:]
book = nbformat.read(source, as_version=4)
# Without times, and without the version of whoever's Python.
NotebookClient(book, timeout=300, kernel_name="python3", record_timing=False).execute()
book.metadata = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
nbformat.write(book, output)
