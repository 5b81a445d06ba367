"""One Hypothesis profile for all: the same examples everywhere, no deadline, few enough to stay quick."""

from hypothesis import Phase, settings

# No shrinking: an example is small as it is, and shrinking at 50 digits takes minutes.
settings.register_profile(
    "eccentric",
    derandomize=True,
    deadline=None,
    max_examples=20,
    database=None,
    phases=(Phase.explicit, Phase.generate),
)
settings.load_profile("eccentric")
