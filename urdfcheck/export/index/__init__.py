"""What an editor asks about a model: where names are defined and used, what expressions became, what links and joints are."""
