"""Shared foundations: errors, atomic file output, paths, table entries, scripts.

    errors       the one error that a user sees; formatting of lists and counts in messages
    places       paths from the user, and folders of the project
    entries      entries of TOML and JSON files: numbers, tables, keys
    scripts      user scripts, executed from their source text
    atomic       atomic output of a file, a set of files, or a command's output folder; printing
    transaction  staging folders next to the target, and replacement of one set of files by another
    locks        advisory file locks; signals deferred while files are moved
    cache        derived and built results in the user's cache
    targets      emission and export targets, listed without importing their implementations

Guarantee, whenever a run is killed: a file is either the old one or the new one, and the files of a set are
never from two runs. Between the first move and the last some may be missing: they are then in the folder
`.eccentric-<hex>` next to the target, with a journal, and the next run that writes there first restores the
old set. The moves take milliseconds, during which interrupts are deferred; SIGKILL cannot be, nor SIGTERM
in a program that does not handle it. Power loss is not covered: nothing is synced to disk.

Locks use `flock`, on a file in each staging folder and, while a set is moved, on `.eccentric-lock` in the
target; on NFS they work across machines. Without locks (Windows, some network file systems) a staging folder
counts as abandoned after an hour; a run that finds a younger journal is refused with one line, and two runs
that move files into one folder within the same milliseconds are not kept apart.

May import: nothing from the toolkit except the time of its import.
"""

from eccentric.core.atomic import (
    UNREAD,
    escape_unprintable,
    folder_to_write,
    nobody_reads,
    own_folder,
    remove_folder,
    show,
    whole_file,
    whole_files,
    whole_folder,
)
from eccentric.core.cache import (
    OURS_ALONE,
    cache_folder,
    derived,
    digest,
    own_bytes,
    own_cache,
    read_cached,
    write_cached,
)
from eccentric.core.entries import read_document, read_number, read_table, read_utf8, refuse_unknown
from eccentric.core.errors import (
    InputError,
    MissingValueError,
    counted,
    derivation,
    few,
    folder,
    given_path,
    is_arm_file,
    meant,
    readable,
    refuse_other_files,
    shown,
    so_more,
    together,
)
from eccentric.core.scripts import asks, loads_behind, remember_loads, run_script, run_text, scripts_behind
from eccentric.core.targets import EXPORTS, TARGETS
from eccentric.core.transaction import MARKER, Ended, ended_by_signals, held, workshop
