message(FATAL_ERROR "Node.js was missing when the build was configured: apt-get install nodejs npm, then configure again")
