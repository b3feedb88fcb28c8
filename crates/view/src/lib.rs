//! A cell in a browser: the page and the server behind it.
