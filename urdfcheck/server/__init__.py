"""``urdfcheck server``: a language server, which checks what is in an editor's buffers.

Three kinds of processes: this one speaks the protocol and holds the texts; the check process (`check_process`) plans and puts
together runs as ``urdfcheck check`` does; its workers open the files, with the rights and limits of any worker.
"""
