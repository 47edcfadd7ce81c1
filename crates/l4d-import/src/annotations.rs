//! What people drew on pictures with other tools: read into instances, written for the evaluators of others.
