"""Review of model structures: proposals, votes, evidence, audit trail."""
