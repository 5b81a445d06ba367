"""What every room stands on: errors, files that appear whole or not at all, paths, entries, scripts.

    errors       the one error that a user sees, and how lists and counts are put in a message
    places       paths that a user gave, and folders of the project
    entries      entries of TOML and JSON files: numbers, tables, keys
    scripts      scripts of a user, run from their text
    atomic       one file, a set of files, or a folder of a command's files; what is printed
    transaction  a temporary folder beside the target, and a set of files in the place of another
    locks        who writes where: advisory locks of files; signals that are deferred while files are moved
    cache        what was derived or built once, in the user's cache
    targets      what models are emitted for and exported to, without importing what does so

What holds, whenever a run is killed: a file is the old one or the new one. Files of one set that are there
are all of one run; between the first move and the last some may be missing. They are then in the folder
`.eccentric-<hex>` beside them, with a journal, and the next run that writes there puts the old set back
before it does anything else. That takes milliseconds, for which interrupts wait; SIGKILL does not, nor does
SIGTERM in a program that leaves it to the system. A loss of power is not covered: nothing waits for the disk.

Locks are those of `flock`, on a file in each temporary folder and, while a set is moved, on `.eccentric-lock`
in the target; on NFS they hold between machines. Where there are none (Windows, some network file systems)
a temporary folder is taken for abandoned after an hour; a run that finds a younger journal is refused with
one line, and two that move files into one folder within the same milliseconds are not kept apart.

May import: nothing of the toolkit but the time of its import.
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
from eccentric.core.errors import InputError, MissingValueError, counted, few, meant, so_more, together
from eccentric.core.locks import Ended, ended_by_signals, held
from eccentric.core.places import (
    derivation,
    folder,
    given_path,
    is_arm_file,
    readable,
    refuse_other_files,
    shown,
)
from eccentric.core.scripts import asks, loads_behind, remember_loads, run_script, run_text, scripts_behind
from eccentric.core.targets import EXPORTS, TARGETS
from eccentric.core.transaction import MARKER, workshop
