"""The server process."""

import uvicorn

from app.main import create_app
from app.settings import Settings


def serve(settings: Settings | None = None) -> None:
    """Serve until SIGTERM or SIGINT; running jobs are queued again and go on at the next start."""
    settings = settings or Settings()
    uvicorn.run(create_app(settings), host=settings.host, port=settings.port, access_log=False)


if __name__ == "__main__":
    serve()
