# The names of the door, each from the file that defines it; `eccentric.api` reads this list.

from eccentric.api.adapted import AdaptResult as AdaptResult
from eccentric.api.adapted import adapt as adapt
from eccentric.api.compared import CompareResult as CompareResult
from eccentric.api.compared import compare as compare
from eccentric.api.diagnosed import DiagnosisResult as DiagnosisResult
from eccentric.api.diagnosed import diagnose as diagnose
from eccentric.api.emitted import emit as emit
from eccentric.api.fitted import FitResult as FitResult
from eccentric.api.fitted import fit as fit
from eccentric.api.of_arms import ArmDiagnosisResult as ArmDiagnosisResult
from eccentric.api.of_arms import ArmFitResult as ArmFitResult
from eccentric.api.of_arms import diagnose_arm as diagnose_arm
from eccentric.api.of_arms import fit_arm as fit_arm
from eccentric.api.planned import PlanResult as PlanResult
from eccentric.api.planned import plan as plan
from eccentric.api.simulated import BenchResult as BenchResult
from eccentric.api.simulated import bench as bench
from eccentric.api.simulated_arm import ArmBenchResult as ArmBenchResult
from eccentric.api.simulated_arm import bench_arm as bench_arm
from eccentric.api.tables import Correlation as Correlation
from eccentric.api.tables import ResultTable as ResultTable
