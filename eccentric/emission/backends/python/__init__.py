"""What the back ends that write Python share; it writes nothing itself.

    dialect     what differs between them, as a record, and the language of expressions that follows from it
    module      the variables that the templates of a module have in common; `prepare`
    functions   routines and helpers as functions; shared parts get a name, the rest stays in its line

Their templates share `templates/python`.
"""
