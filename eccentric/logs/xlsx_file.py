"""Workbooks by openpyxl: the longest sheet, read as the text of its cells."""

from __future__ import annotations

import csv
import dataclasses
import datetime as dt
import io
from pathlib import Path
from typing import Any

from eccentric.core import InputError, few
from eccentric.logs.assemble import Read
from eccentric.logs.csv_file import read_text
from eccentric.logs.foreign import library, reading, require_room_for_numbers


def read_xlsx(path: Path) -> Read:
    """Read the sheet with the most rows; formulas are not evaluated, their stored results are read."""
    openpyxl = library("openpyxl", "xlsx", path)
    with reading(path, "workbook"):
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        try:
            sheets = [sheet for sheet in book.worksheets if (sheet.max_row or 0) > 1]
            if not sheets:
                raise InputError(path, "a sheet with rows", "none")
            chosen = max(sheets, key=lambda sheet: sheet.max_row)
            require_room_for_numbers(path, chosen.max_row, chosen.max_row * (chosen.max_column or 1))
            text = io.StringIO()
            writer = csv.writer(text, delimiter=";", lineterminator="\n")
            for row in chosen.iter_rows(values_only=True):
                writer.writerow([_cell(value) for value in row])
        finally:
            book.close()
        others = [sheet.title for sheet in sheets if sheet is not chosen]
        notes = [f"sheet {chosen.title!r} is read"] if others else []
        if others:
            notes.append(f"left out, other sheets: {few(others, 5)}")
        read = read_text(text.getvalue(), path)
    return dataclasses.replace(read, notes=(*notes, *read.notes))


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, dt.datetime | dt.time):
        return value.isoformat(*([" "] if isinstance(value, dt.datetime) else []))
    return str(value)
