"""Serial chains: joints in a row, each with its body and its drive; one joint is the paper's rotating link.

In: `Chain` of `Joint` and `Body`, numbers or expressions.  Out: `recursion(chain)`, the motion, the wrenches
and the loads of the bearings as ordered definitions of scalars.

    links      joint, body and placement; numbers kept exact, so that zeros and ones fold
    chain      joints and bodies in a row, gravity, payload; what tells one chain from another
    motion     how a frame moves in another, differentiated in time; Newton and Euler for a body and a rotor
    recursion  outwards the motion of every body, inwards the wrench of every joint; loads of the bearings
    inertial   a letter for every inertial parameter; torque per parameter that a motion can show
    rest       the arm at rest, and a time step
    outputs    the functions of an arm: torques, loads, friction, regressors
    drive      motor, gear and friction of every joint: its balances; all of it as a model
"""

from eccentric.model.chain import motion
from eccentric.model.chain.chain import Chain, identity_of, unlike, with_numbers
from eccentric.model.chain.drive import DriveSymbols, JointDrive, arm, drive_balances, drives, friction_units
from eccentric.model.chain.inertial import letters_of, with_bodies, with_letters
from eccentric.model.chain.links import Body, Joint, Moments, Placement
from eccentric.model.chain.recursion import Recursion, at_rest, recursion
