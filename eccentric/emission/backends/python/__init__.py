"""What the back ends that write Python share; it writes nothing itself.

    dialect     what differs between them, as a record, and the language of expressions that follows from it
    module      the variables that the templates of a module have in common
    prepare     the function from parameters to coefficients
    functions   routines and helpers as functions, with `inline` and `shared` for lines that a person reads

Their templates share `templates/python`.
"""
