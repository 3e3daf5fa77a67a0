"""What static pages share: the kitchen in JavaScript, its data, and how a page becomes one file."""
