"""Serial chains: joints in series, each with its body and drive; one joint is the paper's rotating link.

In: `Chain` of `Joint` and `Body`, numbers or expressions.  Out: `recursion(chain)`, the motion, the wrenches
and the bearing loads as ordered scalar definitions.

    links      joint, body and placement, with exact numbers, so that zeros and ones fold
    chain      joints and bodies in series, gravity, payload; comparison of chains
    motion     motion of a frame in its carrier, differentiated in time; Newton and Euler for body and rotor
    recursion  outwards the motion of every body, inwards the wrench of every joint; bearing loads
    inertial   symbols for inertial parameters; the regressor of the identifiable ones
    rest       the arm at rest, and a time step
    outputs    the functions of an arm: torques, loads, friction, regressors
    drive      motor, gear and friction of every joint: its balances; the complete model
"""

from eccentric.model.chain import motion
from eccentric.model.chain.chain import Chain, identity_of, unlike, with_numbers
from eccentric.model.chain.drive import DriveSymbols, JointDrive, arm, drive_balances, drives, friction_units
from eccentric.model.chain.inertial import letters_of, with_bodies, with_letters
from eccentric.model.chain.links import Body, Joint, Moments, Placement
from eccentric.model.chain.outputs import ArmOutputs
from eccentric.model.chain.recursion import Recursion, at_rest, recursion
