"""Serial chains: joints in a row, each with its body and its drive; one joint is the paper's rotating link.

In: `Chain` of `Joint` and `Body`, numbers or expressions.  Out: `recursion(chain)`, the motion, the wrenches
and the loads of the bearings as ordered definitions of scalars.

    exact      numbers kept exact, so that zeros and ones fold
    body       mass, centre of mass, inertia, and their moments
    joint      kind, axis, placement, gear ratio, rotor
    chain      joints and bodies in a row, gravity, payload
    motion     how a frame moves in another: position and rotation, differentiated in time
    momentum   Newton and Euler: the mass points of a body, summed; the rotor of a drive
    outwards   the motion of a body from that of its parent
    inwards    the force and moment of every joint
    recursion  both along the chain, as a list of definitions
    bearing    the loads that friction follows
    rest       the recursion without motion
    letters    a chain with a letter for every inertial parameter
    given_bodies  a chain with the bodies that a fit found
    identity   what tells one chain from another
    numbers    a chain with the defaults of its letters in their place
    drive      motor, gear and friction of every joint: its balances
    arm        all of it as a model
"""

from eccentric.model.chain import momentum, motion
from eccentric.model.chain.arm import arm
from eccentric.model.chain.bearing import Bearing
from eccentric.model.chain.body import Body, Moments
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.drive import JointDrive, drives, friction_units
from eccentric.model.chain.given_bodies import with_bodies
from eccentric.model.chain.identity import identity_of, unlike
from eccentric.model.chain.inwards import Wrench
from eccentric.model.chain.joint import Joint, Placement
from eccentric.model.chain.letters import letters_of, with_letters
from eccentric.model.chain.numbers import with_numbers
from eccentric.model.chain.recursion import Recursion, recursion
from eccentric.model.chain.rest import at_rest

__all__ = [
    "Bearing",
    "Body",
    "Chain",
    "Joint",
    "JointDrive",
    "Moments",
    "Placement",
    "Recursion",
    "Wrench",
    "arm",
    "at_rest",
    "drives",
    "friction_units",
    "identity_of",
    "letters_of",
    "momentum",
    "motion",
    "recursion",
    "unlike",
    "with_bodies",
    "with_letters",
    "with_numbers",
]
