solve_function, available_solvers, dense_solvers, sparse_solvers = {}, [], [], []
