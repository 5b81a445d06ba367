# The public names, each from the room that defines it; `import eccentric` reads this list.

from eccentric.api import AdaptResult as AdaptResult
from eccentric.api import ArmBenchResult as ArmBenchResult
from eccentric.api import ArmDiagnosisResult as ArmDiagnosisResult
from eccentric.api import ArmFitResult as ArmFitResult
from eccentric.api import BenchResult as BenchResult
from eccentric.api import CompareResult as CompareResult
from eccentric.api import Correlation as Correlation
from eccentric.api import DiagnosisResult as DiagnosisResult
from eccentric.api import FitResult as FitResult
from eccentric.api import PlanResult as PlanResult
from eccentric.api import ResultTable as ResultTable
from eccentric.api import adapt as adapt
from eccentric.api import bench as bench
from eccentric.api import bench_arm as bench_arm
from eccentric.api import compare as compare
from eccentric.api import diagnose as diagnose
from eccentric.api import diagnose_arm as diagnose_arm
from eccentric.api import emit as emit
from eccentric.api import fit as fit
from eccentric.api import fit_arm as fit_arm
from eccentric.api import plan as plan
from eccentric.compiled import compile as compile  # noqa: A004 - called as eccentric.compile
from eccentric.errors import InputError as InputError
from eccentric.logs import Log as Log
from eccentric.logs import read_log as read_log
from eccentric.model import Model as Model
from eccentric.model import load_model as load_model
from eccentric.rigs import ArmRig as ArmRig
from eccentric.rigs import Rig as Rig
from eccentric.rigs import read_arm_rig as read_arm_rig
from eccentric.rigs import read_rig as read_rig
from eccentric.version import __version__ as __version__
