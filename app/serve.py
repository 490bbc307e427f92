"""The server process."""

import uvicorn
from pydantic import ValidationError
from pydantic_settings import SettingsError

from app.main import create_app
from app.settings import Settings


def serve() -> None:
    """Serve until SIGTERM or SIGINT; running jobs are queued again and go on at the next start.

    Settings that are refused end the program with what to change.
    """
    try:
        settings = Settings()
    except ValidationError as error:
        raise SystemExit("\n".join(_explained(error))) from None
    except SettingsError as error:
        raise SystemExit(str(error)) from None
    uvicorn.run(create_app(settings), host=settings.host, port=settings.port, access_log=False)


def _explained(error: ValidationError) -> list[str]:
    prefix = Settings.model_config["env_prefix"]
    lines = []
    for failure in error.errors(include_input=False, include_url=False):
        message = str(failure.get("ctx", {}).get("error", failure["msg"]))
        lines.append(": ".join([*(f"{prefix}{name}".upper() for name in failure["loc"]), message]))
    return lines


if __name__ == "__main__":
    serve()
