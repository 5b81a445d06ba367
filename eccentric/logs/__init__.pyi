# The names of the door, each from the file that defines it.

from eccentric.logs.assemble import number_of as number_of
from eccentric.logs.clocks import falls as falls
from eccentric.logs.clocks import mended as mended
from eccentric.logs.formats import FORMATS as FORMATS
from eccentric.logs.formats import format_of as format_of
from eccentric.logs.log import Excerpt as Excerpt
from eccentric.logs.log import Log as Log
from eccentric.logs.log import LogSource as LogSource
from eccentric.logs.log import LogStream as LogStream
from eccentric.logs.log import log_names as log_names
from eccentric.logs.log import log_stems as log_stems
from eccentric.logs.log import read_log as read_log
from eccentric.logs.log import stream_log as stream_log
from eccentric.logs.tables import arrow_columns as arrow_columns
from eccentric.logs.units import Unit as Unit
from eccentric.logs.units import column_names as column_names
from eccentric.logs.units import evaluate as evaluate
from eccentric.logs.units import is_arithmetic as is_arithmetic
from eccentric.logs.units import parse_unit as parse_unit
from eccentric.logs.units import parse_value as parse_value
from eccentric.logs.units import require_unit as require_unit
